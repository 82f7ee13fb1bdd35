"""The strawberry paper's handling mechanism and its three methods (S; docs/strawberry.md).

An XYZ table with an arm of three joints, no approach direction and no wrist: it shares names of
methods with the arms in `solver/robots`, and nothing else, and is reached by comparing methods.
"""
