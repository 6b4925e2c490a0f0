"""The programs that read robot descriptions are given the files of `dh2urdf check`: what do they make of them?"""
