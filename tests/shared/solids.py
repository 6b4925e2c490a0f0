"""A small mesh that tests draw links with."""

CORNERS = ((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1))
STL = "\n".join(
    [
        "solid tetrahedron",
        *(
            "facet normal 0 0 0\nouter loop\n"
            + "".join(f"vertex {x} {y} {z}\n" for x, y, z in (CORNERS[corner] for corner in face))
            + "endloop\nendfacet"
            for face in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
        ),
        "endsolid tetrahedron\n",
    ]
).encode()
"""A tetrahedron of four facets."""
