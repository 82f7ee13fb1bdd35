"""Approaches of arms without a closed form, by Newton's method from many starts."""
