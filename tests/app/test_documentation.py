"""`/docs` works on a machine without internet."""

import re

from tests.app.conftest import Server


def test_page_loads_only_from_the_service(server: Server) -> None:
    page = server.client.get("/docs")
    assert page.status_code == 200
    assert page.headers["content-type"].startswith("text/html")
    loaded = re.findall(r"""(?:src|href)=["']([^"']+)["']|url: ["']([^"']+)["']""", page.text)
    addresses = [first or second for first, second in loaded]
    assert len(addresses) == 4
    assert "/openapi.json" in addresses
    for address in addresses:
        assert address.startswith("/")
        assert not address.startswith("//")
        answer = server.client.get(address)
        assert answer.status_code == 200
        assert answer.content
    assert "://" not in page.text
    assert '"validatorUrl": null' in page.text


def test_style_loads_nothing_more(server: Server) -> None:
    style = server.client.get("/docs/files/swagger-ui.css").text
    assert "@import" not in style
    for address in re.findall(r"url\(\s*[\"']?([^\"')]{5})", style):
        assert address == "data:", address


def test_no_other_page_is_there(server: Server) -> None:
    assert server.client.get("/redoc").status_code == 404
    assert server.client.get("/docs/files/%2e%2e/core.py").status_code == 404
