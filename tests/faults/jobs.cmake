# Jobs on a store that fails.
fascicle_test(job_faults_test SOURCES job_faults_test.cc DEPS tests/jobs tests/store server/jobs TIMEOUT 180)
