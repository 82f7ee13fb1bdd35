"""RFC 9457 problem details."""

from pydantic import BaseModel, Field

MEDIA_TYPE = "application/problem+json"


class FieldFault(BaseModel):
    """One thing wrong in a request."""

    pointer: str = Field(description="JSON pointer to the field, in URI fragment form (RFC 6901)")
    detail: str


class ProblemDetails(BaseModel):
    """The body of every answer that is an error."""

    type: str = Field(description="urn:prunus:problem:CODE")
    title: str
    status: int
    detail: str
    errors: list[FieldFault] = Field(description="what is wrong where; empty if no field is")
