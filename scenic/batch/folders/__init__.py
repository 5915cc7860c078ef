"""Folders that commands write over time: who writes (`lock`), what they hold (`folder`, `ranges`), what decides it (`file_digests`)."""
