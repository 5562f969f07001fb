from .character import Character


def build() -> Character:
    raise NotImplementedError
