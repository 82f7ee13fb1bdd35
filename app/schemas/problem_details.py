"""RFC 9457 problem details."""

from pydantic import BaseModel, Field

MEDIA_TYPE = "application/problem+json"


class FieldFault(BaseModel):
    """One thing wrong in a request."""

    pointer: str = Field(description="JSON pointer to the field, in URI fragment form (RFC 6901)")
    detail: str = Field(description="what is wrong with it, for people; never what was sent")


class ProblemDetails(BaseModel):
    """The body of every answer that is an error."""

    type: str = Field(
        description="urn:prunus:problem:CODE; docs/errors.md has the codes, more may come"
    )
    title: str = Field(description="the code in words")
    status: int = Field(description="the answer's HTTP status, 4xx or 5xx")
    detail: str = Field(description="what is wrong, a sentence for people; never what was sent")
    errors: list[FieldFault] = Field(
        description="what is wrong where, 100 at most; empty if no field is"
    )
