import json, os, uuid
from prunus_client import Client
from prunus_client.api.plans import create_plan
from prunus_client.models import PlanAnswer, PlanRequest

client = Client(base_url=os.environ.get("PRUNUS_URL", "http://127.0.0.1:8000"))
request = PlanRequest.from_dict(json.load(open("openapi/examples/data_set_3.json")))
answer = create_plan.sync(client=client, body=request, idempotency_key=str(uuid.uuid4()))
for approach in answer.approaches if isinstance(answer, PlanAnswer) else []:
    print(approach.target_id, approach.status, approach.approach_angle_rad)
