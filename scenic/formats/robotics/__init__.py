"""Scenes as files of robot simulators: OpenUSD, MJCF, SDFormat with URDF."""
