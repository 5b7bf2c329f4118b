"""A page as a reader, a keyboard or a screen reader meets it: elements, words, what is unfolded."""

import html.parser

VOID = {"meta", "img", "link", "br"}
"""Elements without an end tag."""


class Tree(html.parser.HTMLParser):
    """Elements of a page with their attributes, their parents and their text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[dict[str, str]] = []
        self.open: list[int] = []
        self.texts: list[tuple[list[str], str]] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        above = " ".join(self.found[i]["tag"] for i in self.open)
        classes = " ".join(self.found[i].get("class", "") for i in self.open)
        own = {name: value or "" for name, value in attrs}
        self.found.append({**own, "tag": tag, "above": above, "classes": classes, "text": ""})
        if tag not in VOID:
            self.open.append(len(self.found) - 1)

    def handle_endtag(self, tag: str) -> None:
        if tag in VOID:
            return
        while self.open and self.found[self.open[-1]]["tag"] != tag:
            self.open.pop()
        if self.open:
            self.open.pop()

    def handle_data(self, data: str) -> None:
        self.texts.append(([self.found[i]["tag"] for i in self.open], data))
        for i in self.open:
            self.found[i]["text"] += data

    def every(self, *tags: str) -> list[dict[str, str]]:
        return [one for one in self.found if one["tag"] in tags]

    @property
    def words(self) -> str:
        """Text outside pictures and styles."""
        kept = [text for above, text in self.texts if not {"svg", "style"} & {*above}]
        return " ".join(" ".join(kept).split())

    @property
    def unfolded(self) -> list[str]:
        """Words that are seen before anything is unfolded, the outermost summaries among them."""
        kept = [
            text
            for above, text in self.texts
            if not {"svg", "style", "title"} & {*above}
            and above.count("details") <= ("summary" in above)
        ]
        return " ".join(kept).split()
