"""Servos as data: control tables, which servo drives which joint, calibrations, ticks and units."""
