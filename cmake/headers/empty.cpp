// A target that needs one source.
