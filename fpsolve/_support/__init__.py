"""What every room uses and no formula names: checks, files, threads, labels."""
