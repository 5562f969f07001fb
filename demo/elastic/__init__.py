"""The law of flesh beside elastic solids: near-incompressible flesh around rigid bones, solved by others."""
