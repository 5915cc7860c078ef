"""Names of the Webots simulator."""
