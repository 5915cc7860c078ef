"""Road maps in the OpenDRIVE format: from text to records, and the curves of reference lines."""
