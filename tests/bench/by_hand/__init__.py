"""Problems as an expert would write them for IDA in C, and as minimal equations: yardsticks, with no generality in them."""
