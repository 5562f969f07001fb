# A joint preset of Turgor.
{
    "turgor_joint": 1,
    "strength": 1.0,
    "size": 0.7,
    "blend_mode": "NONE",
    "blend": 0.0,
    "fold_loss": 0.1,
    "first": {
        "preset": "RUBBER",
        "curve_source": "RUBBER",
        "use_auto_shares": True,
        "shares": (0.3333333333333333, 0.3333333333333333, 0.3333333333333333),
        "curves": [],
    },
    "second": {
        "preset": "ISOTROPIC",
        "curve_source": "ISOTROPIC",
        "use_auto_shares": True,
        "shares": (0.3333333333333333, 0.3333333333333333, 0.3333333333333333),
        "curves": [],
    },
}
