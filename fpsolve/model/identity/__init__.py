"""What an object is, as a digest: one for equal objects, another if anything differs.

Results are kept under such digests and found again. A name says too little for that:
two closures share theirs, and so do a function before and after it was edited. Code is
known by its instructions and by all that it refers to, data by its bits, and potentials
and curves by what they compute as well.
"""

from fpsolve.model.identity.digests import digest_or_none, identity_digest
from fpsolve.model.identity.objects import UnidentifiedError

__all__ = ["UnidentifiedError", "digest_or_none", "identity_digest"]
