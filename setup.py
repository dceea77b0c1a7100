"""All is said in pyproject.toml; this makes editable installs take the data files along as wheels do."""

from setuptools import Distribution, setup


class WithData(Distribution):
    """setuptools' editable_wheel asks whether a distribution ``has_data``, and none says so of itself."""

    def has_data(self) -> bool:
        return bool(self.has_data_files())


setup(distclass=WithData)
