"""Robots and what they execute: links to workers, leases, orders, accounts of what was done."""
