"""Requests to problems and plans to answers: batches, frames of targets, plans in parts."""
