"""The commands of `livella`, a file each."""
