"""A page taken apart with the parser of the standard library."""

from html.parser import HTMLParser

VOID = {"meta", "link", "img", "br", "hr", "input"}


class Page(HTMLParser):
    """Elements with their attributes, the text in them, and whether tags match."""

    def __init__(self, html):
        super().__init__(convert_charrefs=True)
        self.elements, self.open, self.texts = [], [], []
        self.feed(html)
        self.close()
        assert self.open == [], f"never closed: {self.open}"

    def handle_starttag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.elements.append((tag, dict(attributes)))

    def handle_endtag(self, tag):
        assert self.open, f"</{tag}> closes nothing"
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.texts.append((self.open[-1] if self.open else "", data))

    def all(self, tag):
        """Attributes of every element of that name."""
        return [attributes for name, attributes in self.elements if name == tag]

    def text(self, *tags):
        """Text directly inside of these elements, by default all but styles."""
        parts = [
            data for tag, data in self.texts
            if (tag in tags if tags else tag != "style")
        ]  # fmt: skip
        return " ".join(" ".join(parts).split())
