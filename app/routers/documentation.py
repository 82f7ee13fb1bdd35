"""The interface description as a page to read and try, without internet."""

from pathlib import Path

import fastapi_offline
from fastapi import APIRouter, FastAPI, Response
from fastapi.openapi.docs import get_swagger_ui_html
from fastapi.staticfiles import StaticFiles

PAGE = "/docs"
FILES = "/docs/files"
OPENAPI = "/openapi.json"

router = APIRouter()


def mount_files(app: FastAPI) -> None:
    """Serve Swagger UI's files from the installed package, so that nothing comes from elsewhere."""
    folder = Path(fastapi_offline.__file__).parent / "static"
    app.mount(FILES, StaticFiles(directory=folder))


@router.get(PAGE, include_in_schema=False)
async def documentation() -> Response:
    """Swagger UI on this service's own document."""
    return get_swagger_ui_html(
        openapi_url=OPENAPI,
        title="Prunus",
        swagger_js_url=f"{FILES}/swagger-ui-bundle.js",
        swagger_css_url=f"{FILES}/swagger-ui.css",
        swagger_favicon_url=f"{FILES}/favicon.png",
        # Swagger UI would otherwise send the document's address to its maker's validator.
        swagger_ui_parameters={"validatorUrl": None},
    )
