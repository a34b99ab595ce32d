"""How accurate, how honest and how careful the estimator is, on thousands of simulated drives and on real ones."""
