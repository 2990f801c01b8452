"""Many scans: a batch on Dask into a store, the trend of each gear over its inspections, and the gauge study of repeated scans."""
