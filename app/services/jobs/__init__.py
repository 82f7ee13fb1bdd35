"""Large batches as jobs: taken on, worked on part by part, resumed after a stop."""
