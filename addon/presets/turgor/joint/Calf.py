# A joint preset of Turgor.
{
    "turgor_joint": 1,
    "strength": 1.0,
    "size": 1.1,
    "blend_mode": "NONE",
    "blend": 0.0,
    "fold_loss": 0.1,
    "first": {
        "preset": "CUSTOM",
        "curve_source": "MUSCLE",
        "use_auto_shares": False,
        "shares": (0.1, 0.2, 0.7),
        "curves": [
            {
                "is_symmetric": False,
                "points": (
                    (0, 0, "AUTO_CLAMPED"),
                    (0.4, 0.05, "AUTO_CLAMPED"),
                    (0.55, 0.4, "AUTO_CLAMPED"),
                    (0.68, 1, "AUTO_CLAMPED"),
                    (0.84, 0.3, "AUTO_CLAMPED"),
                    (1, 0, "AUTO_CLAMPED"),
                ),
            },
            {
                "is_symmetric": True,
                "points": (
                    (0, 1, "AUTO_CLAMPED"),
                    (0.05, 0.99, "AUTO_CLAMPED"),
                    (0.27, 0.48, "AUTO_CLAMPED"),
                    (0.55, 0.05, "AUTO_CLAMPED"),
                    (1, 0, "AUTO_CLAMPED"),
                ),
            },
            {
                "is_symmetric": False,
                "points": (
                    (0, 0, "AUTO_CLAMPED"),
                    (0.5, 0.05, "AUTO_CLAMPED"),
                    (0.62, 0.6, "AUTO_CLAMPED"),
                    (0.75, 1, "AUTO_CLAMPED"),
                    (0.9, 0.25, "AUTO_CLAMPED"),
                    (1, 0, "AUTO_CLAMPED"),
                ),
            },
        ],
    },
    "second": {
        "preset": "ISOTROPIC",
        "curve_source": "ISOTROPIC",
        "use_auto_shares": True,
        "shares": (0.3333333333333333, 0.3333333333333333, 0.3333333333333333),
        "curves": [],
    },
}
