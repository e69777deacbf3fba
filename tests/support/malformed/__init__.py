"""What users get wrong: one table for each way in.

Each row says what is wrong, does it, and names what the message must say of the value
and of the way out. `tests/input/test_malformed*.py` drive the tables; a new mistake is
one more row.
"""
