"""IDA through the SUNDIALS libraries that scikit-sundae carries, with compiled residual and Jacobian."""
