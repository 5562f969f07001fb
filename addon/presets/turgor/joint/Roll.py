# A joint preset of Turgor.
{
    "turgor_joint": 1,
    "strength": 1.0,
    "size": 1.0,
    "blend_mode": "LOSS",
    "blend": 0.0,
    "fold_loss": 0.25,
    "first": {
        "preset": "BELLY",
        "curve_source": "BELLY",
        "use_auto_shares": True,
        "shares": (0.3333333333333333, 0.3333333333333333, 0.3333333333333333),
        "curves": [],
    },
    "second": {
        "preset": "BELLY_FOLDED",
        "curve_source": "BELLY_FOLDED",
        "use_auto_shares": True,
        "shares": (0.3333333333333333, 0.3333333333333333, 0.3333333333333333),
        "curves": [],
    },
}
