"""Folds that the correction makes, with and without their repair: a deep elbow and a belly."""
