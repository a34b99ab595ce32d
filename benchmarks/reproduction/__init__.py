"""The experiments of thesis chapter 5, run on simulated drives."""
