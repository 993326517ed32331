//! Models that once had a wrong answer, or were refused with a sentence that misleads: tests/data/cases.

