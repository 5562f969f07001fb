"""The experiments of [ZR13], Zhuo and Rossignac: Fleshing, beside Blender's Curve modifier: tables, plots, pictures.

Its figures 3, 4 and 6 to 10 and its table 1, each a module here that gives one `Experiment`.
"""
