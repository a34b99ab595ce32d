"""The service under the load of a fleet: how many devices two cores hold, and what a chunk costs."""
