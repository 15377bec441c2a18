"""IDA through the SUNDIALS libraries of scikit-sundae, with compiled residual and Jacobian."""
