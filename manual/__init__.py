"""The manual: `manual.md` and pictures of a real window become one page that ships with the extension."""
