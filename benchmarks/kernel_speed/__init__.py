"""Speed of the estimator, beside filters of the same size in plain numpy and filterpy."""
