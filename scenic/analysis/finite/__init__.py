"""The finite part of a program: requirements that couple discrete values, decided instead of tried."""
