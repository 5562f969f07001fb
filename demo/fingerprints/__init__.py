"""Fingerprints of what characters look like with Turgor: equal before and after a change that must not change a bit."""
