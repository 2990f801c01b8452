"""Scans of gears by a generator that shares nothing with the program: families of hard cases, each judged by itself."""
