"""From a laboratory's tests to a bearing: records, checks, fit, uncertainty, report."""
