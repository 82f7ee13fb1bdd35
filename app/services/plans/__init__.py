"""Wire to solver and back: batches read and checked, frames of targets, plans whole or in parts."""
