"""Compiled loops: arrays and scalars in, `out` written last, nothing checked.

Every kernel is a free function with an on-disk cache. Floating-point contraction
(fused multiply-add) is the only relaxation allowed, so NaN and infinity survive;
results are bitwise the same on any number of threads.
"""
