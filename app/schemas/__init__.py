"""The wire: pydantic models of requests and answers, a file a resource."""
