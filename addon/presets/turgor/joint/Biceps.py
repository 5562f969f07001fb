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
        "shares": (0.1, 0.15, 0.75),
        "curves": [
            {
                "is_symmetric": False,
                "points": (
                    (0, 0, "AUTO_CLAMPED"),
                    (0.15, 0.12, "AUTO_CLAMPED"),
                    (0.3, 1, "AUTO_CLAMPED"),
                    (0.45, 0.5, "AUTO_CLAMPED"),
                    (0.6, 0.06, "AUTO_CLAMPED"),
                    (1, 0, "AUTO_CLAMPED"),
                ),
            },
            {
                "is_symmetric": True,
                "points": (
                    (0, 1, "AUTO_CLAMPED"),
                    (0.05, 0.99, "AUTO_CLAMPED"),
                    (0.22, 0.6, "AUTO_CLAMPED"),
                    (0.5, 0.06, "AUTO_CLAMPED"),
                    (1, 0, "AUTO_CLAMPED"),
                ),
            },
            {
                "is_symmetric": False,
                "points": (
                    (0, 0, "AUTO_CLAMPED"),
                    (0.5, 0.04, "AUTO_CLAMPED"),
                    (0.62, 0.7, "AUTO_CLAMPED"),
                    (0.74, 1, "AUTO_CLAMPED"),
                    (0.88, 0.3, "AUTO_CLAMPED"),
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
