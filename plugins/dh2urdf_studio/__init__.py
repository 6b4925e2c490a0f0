"""The studio: a page in the browser where a table is typed and the arm moves beside it.

What it shows is thought out in modules that know no browser: tables and their edits (`edits`, `history`,
`conversions`), the readers' answers (`reading`), what is to be drawn (`scene`), what is handed over (`save`), and
a tab's state (`session`). `page`, `view_page`, `widgets` and `server` put it on the screen, with NiceGUI, which the
extra ``dh2urdf[studio]`` installs; nothing outside them imports it.
"""
