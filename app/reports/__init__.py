"""Comparisons for people and programs: JSON, CSV, Markdown, HTML, and their folder."""
