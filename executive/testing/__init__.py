"""The conformance kit: hold an installed plugin, robot or leaf to its contract.

`executive plugins test CAPABILITY NAME` runs it, and so does, with pytest's own options,

    pytest -p executive.testing.pytest_plugin --pyargs executive.testing --capability segmentation

The contract is in the docstrings of `executive.interfaces`; `suites` holds the checks, `exercises`
the inputs and the calls that they make of each capability, `stand_ins` the fakes that a plugin is
given for the capabilities that it needs.
"""
