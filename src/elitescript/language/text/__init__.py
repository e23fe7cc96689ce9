"""The text of a program: lines, tokens, blocks, and its rewriting into Python with positions kept."""
